/* Characters of a model, frame by frame, from C:
 *
 *     stream MODEL PROMPT [PRIOR]
 *
 * MODEL is a model file or a run's folder; PRIOR is a clip, which a model of classes continues. A hundred
 * characters stand in rows of ten; half of them do something else after two seconds. */
#include <motiongan.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { characters = 100 };

/* Stops the program where a call fails. */
static void need(motiongan_status status) {
  if (status == MOTIONGAN_OK) return;
  fprintf(stderr, "%s: %s\n", motiongan_status_name(status), motiongan_last_error());
  exit(1);
}

int main(int argc, char** argv) {
  motiongan_model model;
  motiongan_stream stream;
  motiongan_clip prior = 0;
  static motiongan_start starts[characters];
  static uint64_t ids[characters];
  size_t joints, words, i, frame, frames;
  double rate, metres;
  float *rotations, *positions;
  const char* other;

  if (argc < 3) {
    fprintf(stderr, "usage: %s MODEL PROMPT [PRIOR]\n", argv[0]);
    return 2;
  }
  printf("motiongan %s\n", motiongan_version());
  need(motiongan_model_open(argv[1], NULL, &model));
  if (argc > 3) need(motiongan_clip_read(argv[3], &prior));
  need(motiongan_joint_count(model, &joints));
  need(motiongan_model_rate(model, &rate));
  need(motiongan_model_unit(model, &metres));
  need(motiongan_model_prompt_count(model, &words));
  need(motiongan_model_prompt(model, words - 1, &other));
  printf("%zu joints, %g frames per second, %zu words or classes; the last one is '%s'\n", joints, rate,
         words, other);

  need(motiongan_stream_create(model, &stream));
  memset(starts, 0, sizeof starts);
  for (i = 0; i < characters; ++i) {
    starts[i].prompt = argv[2];
    starts[i].seed = 1;
    starts[i].sample = (uint32_t)i; /* each has noise of its own */
    starts[i].prior = prior;
    starts[i].placed = 1;
    starts[i].x = 2 / (metres > 0 ? metres : 0.01) * (double)(i % 10); /* two metres apart */
    starts[i].z = 2 / (metres > 0 ? metres : 0.01) * (double)(i / 10);
  }
  need(motiongan_stream_add(stream, starts, characters, ids));

  /* The arrays of all frames: rotations for the engine's skeleton, and where the joints are in the world. */
  rotations = malloc(characters * joints * 4 * sizeof *rotations);
  positions = malloc(characters * joints * 3 * sizeof *positions);
  if (rotations == NULL || positions == NULL) return 1;
  frames = (size_t)(4 * rate);
  for (frame = 0; frame < frames; ++frame) {
    if (frame == frames / 2)
      for (i = 0; i < characters; i += 2) need(motiongan_stream_set_prompt(stream, ids[i], other));
    need(motiongan_stream_step(stream));
    need(motiongan_stream_get(stream, NULL, characters, MOTIONGAN_LOCAL_ROTATIONS, rotations,
                              characters * joints * 4));
    need(motiongan_stream_get(stream, NULL, characters, MOTIONGAN_GLOBAL_POSITIONS, positions,
                              characters * joints * 3));
    if (frame % (frames / 4) == 0)
      printf("frame %2zu: the first root is at %.1f %.1f %.1f\n", frame, (double)positions[0],
             (double)positions[1], (double)positions[2]);
  }
  free(rotations);
  free(positions);
  need(motiongan_close(stream));
  if (prior != 0) need(motiongan_close(prior));
  need(motiongan_close(model));
  return 0;
}
