/* The C interface as a program in C uses it: every call, with a model of each kind. */
#include <motiongan.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if MOTIONGAN_VERSION < MOTIONGAN_MAKE_VERSION(0, 1, 0)
#error "MOTIONGAN_VERSION cannot be compared"
#endif

static int checks = 0, failures = 0;

static void check(int holds, const char* what, int line) {
  ++checks;
  if (holds) return;
  ++failures;
  fprintf(stderr, "line %d: %s (last error: %s)\n", line, what, motiongan_last_error());
}
#define CHECK(condition) check((condition) != 0, #condition, __LINE__)
#define CHECK_OK(call) check((call) == MOTIONGAN_OK, #call, __LINE__)

/* A path in the folder of models; valid until the next call. */
static const char* in(const char* folder, const char* name) {
  static char path[4096];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  return path;
}

static float* floats(size_t count) {
  float* const out = malloc(count * sizeof(float));
  if (out == NULL) exit(2);
  return out;
}

static double distance(double a, double b) { return a < b ? b - a : a - b; }

/* Joints of a model or a clip: a tree, with names and offsets. */
static void check_joints(uint64_t handle, size_t joints) {
  size_t count = 0, named = 0, j;
  int32_t* const parents = malloc(joints * sizeof(int32_t));
  float* const offsets = floats(3 * joints);
  CHECK_OK(motiongan_joint_count(handle, &count));
  CHECK(count == joints);
  CHECK_OK(motiongan_joint_parents(handle, parents, joints));
  CHECK_OK(motiongan_joint_offsets(handle, offsets, 3 * joints));
  for (j = 0; j < joints; ++j) {
    const char* name = NULL;
    CHECK_OK(motiongan_joint_name(handle, j, &name));
    named += name != NULL && strlen(name) > 0;
    CHECK(parents[j] < (int32_t)j && (parents[j] >= 0) == (j > 0));
  }
  CHECK(named == joints);
  CHECK(motiongan_joint_parents(handle, parents, joints - 1) == MOTIONGAN_BUFFER_TOO_SMALL);
  CHECK(motiongan_joint_offsets(handle, offsets, 3 * joints - 1) == MOTIONGAN_BUFFER_TOO_SMALL);
  free(parents);
  free(offsets);
}

/* World positions from local values, by the formulas of docs/c.md. */
static void check_global(const int32_t* parents, size_t joints, const float* rotations,
                         const float* positions, const float* global) {
  float* const turned = floats(4 * joints);
  float* const placed = floats(3 * joints);
  double worst = 0;
  size_t j, axis;
  for (j = 0; j < joints; ++j) {
    const float *q = rotations + 4 * j, *p = positions + 3 * j;
    float *to = turned + 4 * j, *at = placed + 3 * j;
    if (parents[j] < 0) {
      memcpy(to, q, 4 * sizeof *q);
      memcpy(at, p, 3 * sizeof *p);
    } else {
      const float *r = turned + 4 * (size_t)parents[j], *above = placed + 3 * (size_t)parents[j];
      const float x = r[0], y = r[1], z = r[2], w = r[3];
      const float tx = 2 * (y * p[2] - z * p[1]), ty = 2 * (z * p[0] - x * p[2]),
                  tz = 2 * (x * p[1] - y * p[0]);
      at[0] = above[0] + p[0] + w * tx + y * tz - z * ty;
      at[1] = above[1] + p[1] + w * ty + z * tx - x * tz;
      at[2] = above[2] + p[2] + w * tz + x * ty - y * tx;
      to[0] = w * q[0] + x * q[3] + y * q[2] - z * q[1];
      to[1] = w * q[1] - x * q[2] + y * q[3] + z * q[0];
      to[2] = w * q[2] + x * q[1] - y * q[0] + z * q[3];
      to[3] = w * q[3] - x * q[0] - y * q[1] - z * q[2];
    }
    for (axis = 0; axis < 3; ++axis) {
      const double apart = distance(at[axis], global[3 * j + axis]);
      if (apart > worst) worst = apart;
    }
  }
  CHECK(worst < 1e-2); /* of some 90 cm */
  free(turned);
  free(placed);
}

/* A clip of every frame can be read, written and read again. */
static void check_clip(motiongan_clip clip, size_t frames, double rate, const char* folder) {
  size_t found = 0, joints = 0;
  double found_rate = 0;
  motiongan_clip again = 0;
  float *rotations, *positions;
  CHECK_OK(motiongan_clip_frames(clip, &found));
  CHECK(found == frames);
  CHECK_OK(motiongan_clip_rate(clip, &found_rate));
  CHECK(distance(found_rate, rate) < 1e-9);
  CHECK_OK(motiongan_joint_count(clip, &joints));
  check_joints(clip, joints);
  rotations = floats(4 * frames * joints);
  positions = floats(3 * frames * joints);
  CHECK_OK(motiongan_clip_get(clip, MOTIONGAN_LOCAL_ROTATIONS, rotations, 4 * frames * joints));
  CHECK_OK(motiongan_clip_get(clip, MOTIONGAN_GLOBAL_POSITIONS, positions, 3 * frames * joints));
  CHECK(motiongan_clip_get(clip, MOTIONGAN_LOCAL_POSITIONS, positions, 3 * frames * joints - 1) ==
        MOTIONGAN_BUFFER_TOO_SMALL);
  CHECK(motiongan_clip_get(clip, 4, positions, 3 * frames * joints) == MOTIONGAN_INVALID_ARGUMENT);
  CHECK_OK(motiongan_clip_write(clip, in(folder, "written.glb")));
  CHECK_OK(motiongan_clip_write(clip, in(folder, "written.bvh")));
  CHECK(motiongan_clip_write(clip, in(folder, "written.fbx")) == MOTIONGAN_INVALID_ARGUMENT);
  CHECK_OK(motiongan_clip_read(in(folder, "written.bvh"), &again));
  CHECK_OK(motiongan_clip_frames(again, &found));
  CHECK(found == frames);
  CHECK_OK(motiongan_close(again));
  free(rotations);
  free(positions);
}

/* Two characters of a stream, of which one is replaced. */
static void check_stream(motiongan_model model, motiongan_clip prior) {
  motiongan_stream stream = 0;
  motiongan_start starts[2];
  uint64_t ids[2] = {0, 0}, listed[2] = {9, 9};
  size_t joints = 0, count = 0, frame;
  float *rotations, *positions, *global;
  int32_t* parents;
  memset(starts, 0, sizeof starts);
  starts[0].prompt = starts[1].prompt = "run";
  starts[0].prior = starts[1].prior = prior;
  starts[1].sample = 1;
  starts[1].placed = 1;
  starts[1].x = 200;
  CHECK_OK(motiongan_joint_count(model, &joints));
  rotations = floats(4 * 2 * joints);
  positions = floats(3 * 2 * joints);
  global = floats(3 * 2 * joints);
  parents = malloc(joints * sizeof(int32_t));
  CHECK_OK(motiongan_joint_parents(model, parents, joints));
  CHECK_OK(motiongan_stream_create(model, &stream));
  CHECK_OK(motiongan_stream_add(stream, starts, 2, ids));
  CHECK(motiongan_stream_get(stream, ids, 2, MOTIONGAN_LOCAL_ROTATIONS, rotations, 8 * joints) ==
        MOTIONGAN_FAILED);
  CHECK(strstr(motiongan_last_error(), "has not moved") != NULL);
  for (frame = 0; frame < 15; ++frame) {
    if (frame == 7) {
      CHECK_OK(motiongan_stream_set_prompt(stream, ids[0], "jump"));
      CHECK_OK(motiongan_stream_remove(stream, ids[1]));
      CHECK_OK(motiongan_stream_add(stream, starts + 1, 1, ids + 1));
    }
    CHECK_OK(motiongan_stream_step(stream));
    CHECK_OK(motiongan_stream_get(stream, NULL, 2, MOTIONGAN_LOCAL_ROTATIONS, rotations, 8 * joints));
    CHECK_OK(motiongan_stream_get(stream, NULL, 2, MOTIONGAN_LOCAL_POSITIONS, positions, 6 * joints));
    CHECK_OK(motiongan_stream_get(stream, NULL, 2, MOTIONGAN_GLOBAL_POSITIONS, global, 6 * joints));
    check_global(parents, joints, rotations, positions, global);
    check_global(parents, joints, rotations + 4 * joints, positions + 3 * joints, global + 3 * joints);
  }
  CHECK_OK(motiongan_stream_count(stream, &count));
  CHECK(count == 2);
  CHECK_OK(motiongan_stream_ids(stream, listed, 2));
  CHECK(listed[0] == ids[0] && listed[1] == ids[1]);
  CHECK(motiongan_stream_ids(stream, listed, 1) == MOTIONGAN_BUFFER_TOO_SMALL);
  CHECK_OK(motiongan_close(stream));
  CHECK(motiongan_stream_step(stream) == MOTIONGAN_INVALID_HANDLE);
  free(rotations);
  free(positions);
  free(global);
  free(parents);
}

static void check_model(const char* folder, const char* file, motiongan_kind kind) {
  motiongan_model model = 0;
  motiongan_clip prior = 0, clip = 0, continued = 0, copied = 0;
  motiongan_kind found = 0;
  double rate = 0, unit = -1;
  size_t window = 0, prompts = 0, joints = 0, i, known = 0;
  float *rotations, *positions;
  CHECK_OK(motiongan_model_open(in(folder, file), NULL, &model));
  CHECK_OK(motiongan_clip_read(in(folder, "prior.bvh"), &prior));
  CHECK_OK(motiongan_model_kind(model, &found));
  CHECK(found == kind);
  CHECK_OK(motiongan_model_rate(model, &rate));
  CHECK(distance(rate, 10) < 1e-12);
  CHECK_OK(motiongan_model_unit(model, &unit));
  CHECK(unit >= 0);
  CHECK_OK(motiongan_model_frames(model, &window));
  CHECK(window == (kind == MOTIONGAN_CLASSES ? 6 : 8));
  CHECK_OK(motiongan_model_prompt_count(model, &prompts));
  for (i = 0; i < prompts; ++i) {
    const char* prompt = NULL;
    CHECK_OK(motiongan_model_prompt(model, i, &prompt));
    known += prompt != NULL && (strcmp(prompt, "run") == 0 || strcmp(prompt, "jump") == 0);
  }
  CHECK(known == 2);
  CHECK_OK(motiongan_joint_count(model, &joints));
  check_joints(model, joints);

  CHECK_OK(motiongan_clip_make(model, "run", 0, 3, 1, kind == MOTIONGAN_CLASSES ? prior : 0, &clip));
  check_clip(clip, window, rate, folder);
  rotations = floats(4 * window * joints);
  positions = floats(3 * window * joints);
  CHECK_OK(motiongan_clip_get(clip, MOTIONGAN_LOCAL_ROTATIONS, rotations, 4 * window * joints));
  CHECK_OK(motiongan_clip_get(clip, MOTIONGAN_LOCAL_POSITIONS, positions, 3 * window * joints));
  CHECK_OK(motiongan_clip_from_arrays(model, rate, window, rotations, 4 * window * joints, positions,
                                      3 * window * joints, &copied));
  check_clip(copied, window, rate, folder);
  if (kind == MOTIONGAN_TEXT_WINDOW) {
    CHECK(motiongan_clip_make(model, "run", 9, 3, 1, 0, &continued) == MOTIONGAN_FAILED);
    CHECK(motiongan_clip_make(model, "run", 0, 3, 1, prior, &continued) == MOTIONGAN_FAILED);
    CHECK(motiongan_stream_create(model, &continued) == MOTIONGAN_FAILED);
    CHECK(strstr(motiongan_last_error(), "CNN generator") != NULL);
    CHECK(continued == 0);
  } else {
    CHECK_OK(motiongan_clip_make(model, "run", 20, 3, 1, prior, &continued));
    check_clip(continued, 20, rate, folder);
    CHECK_OK(motiongan_close(continued));
    CHECK_OK(motiongan_clip_make(model, "run", 5, 3, 1, copied, &continued));
    check_clip(continued, 5, rate, folder);
    CHECK_OK(motiongan_close(continued));
    check_stream(model, prior);
  }
  CHECK_OK(motiongan_close(clip));
  CHECK_OK(motiongan_close(copied));
  CHECK_OK(motiongan_close(prior));
  CHECK_OK(motiongan_close(model));
  CHECK(motiongan_close(model) == MOTIONGAN_INVALID_HANDLE);
  CHECK(strstr(motiongan_last_error(), "is closed") != NULL);
  free(rotations);
  free(positions);
}

/* A stream with work under way when the process ends, which must not disturb that. */
static void leave_open(const char* folder) {
  motiongan_model model = 0;
  motiongan_stream stream = 0;
  motiongan_start start;
  uint64_t id = 0;
  memset(&start, 0, sizeof start);
  start.prompt = "run";
  CHECK_OK(motiongan_model_open(in(folder, "rnn.safetensors"), NULL, &model));
  CHECK_OK(motiongan_stream_create(model, &stream));
  CHECK_OK(motiongan_stream_add(stream, &start, 1, &id));
}

int main(int argc, char** argv) {
  if (argc != 2) {
    fprintf(stderr, "usage: c_plain FOLDER, which c_models wrote\n");
    return 2;
  }
  CHECK(strlen(motiongan_last_error()) == 0);
  CHECK(strcmp(motiongan_version(), MOTIONGAN_VERSION_STRING) == 0);
  CHECK(strcmp(motiongan_status_name(MOTIONGAN_BUFFER_TOO_SMALL), "MOTIONGAN_BUFFER_TOO_SMALL") == 0);
  CHECK(strcmp(motiongan_status_name(99), "unknown status") == 0);
  check_model(argv[1], "window.safetensors", MOTIONGAN_TEXT_WINDOW);
  check_model(argv[1], "rnn.safetensors", MOTIONGAN_TEXT_STREAM);
  check_model(argv[1], "classes.safetensors", MOTIONGAN_CLASSES);
  leave_open(argv[1]);
  printf("%d checks, %d failed\n", checks, failures);
  return failures == 0 ? 0 : 1;
}
