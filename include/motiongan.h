/** \file
 * motiongan for C, and for every language that can call C: a compiled library, libmotiongan.so.
 *
 *     motiongan_model model;
 *     motiongan_stream stream;
 *     motiongan_start start = {.prompt = "walk", .seed = 1};
 *     uint64_t walker;
 *     if (motiongan_model_open("save/rnn", NULL, &model) != MOTIONGAN_OK) {
 *       fprintf(stderr, "%s\n", motiongan_last_error());
 *       return 1;
 *     }
 *     motiongan_stream_create(model, &stream);
 *     motiongan_stream_add(stream, &start, 1, &walker);
 *     motiongan_stream_step(stream);
 *     motiongan_stream_get(stream, NULL, 1, MOTIONGAN_LOCAL_ROTATIONS, rotations, 4 * joints);
 *     motiongan_close(stream);
 *     motiongan_close(model);
 *
 * Results. Every call but three returns a motiongan_status. Where it is not MOTIONGAN_OK, nothing was changed
 * (motiongan_stream_step says what it leaves), outputs are not written, and motiongan_last_error() says why.
 *
 * Handles. Models, clips and streams are numbers, never 0, which are not used again. A call with a number
 * that is no handle, a closed one or one of another kind returns MOTIONGAN_INVALID_HANDLE. motiongan_close()
 * ends each. A stream needs neither its model's handle nor those of its priors once it has been made.
 *
 * Arrays are the caller's; their lengths are given in numbers, not in bytes. Strings are UTF-8 and end with
 * 0. A string that a call returns belongs to the library and lives as long as the handle.
 *
 * Space. y is up, coordinates are right-handed. Lengths are in the unit of the clips that the model was
 * trained on: see motiongan_model_unit(). Rotations are quaternions in the order x, y, z, w, of unit length,
 * and turn counter-clockwise as seen from the tip of their axis.
 *
 * Threads. Any thread may use any handle. Calls that work with one model (its clips being made, its streams)
 * wait for each other; to compute in parallel, open the model once for each thread. Do not close a handle
 * while another thread still uses strings of it.
 */
#ifndef MOTIONGAN_H
#define MOTIONGAN_H

#include <stddef.h>
#include <stdint.h>

#include "motiongan_version.h" /* MOTIONGAN_VERSION, MOTIONGAN_MAKE_VERSION: of the headers */

#if defined(__GNUC__)
#define MOTIONGAN_API __attribute__((visibility("default")))
#else
#define MOTIONGAN_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** What became of a call. */
typedef int32_t motiongan_status;
enum {
  MOTIONGAN_OK = 0,               /**< done */
  MOTIONGAN_INVALID_ARGUMENT = 1, /**< NULL, a number out of range, an unknown value of an enum */
  MOTIONGAN_INVALID_HANDLE = 2,   /**< no handle, a closed one, one of another kind; no such character */
  MOTIONGAN_BUFFER_TOO_SMALL = 3, /**< an array is too short; the message says how long it must be */
  MOTIONGAN_FAILED = 4, /**< a file that cannot be read, a text without words, a clip that does not fit ... */
  MOTIONGAN_DEVICE_FAILED = 5, /**< the OpenCL device or its driver failed, or has too little memory */
  MOTIONGAN_OUT_OF_MEMORY = 6, /**< too little memory of the host */
  MOTIONGAN_INTERNAL_ERROR = 7 /**< should not happen: please report it */
};

typedef uint64_t motiongan_model;  /**< handle of a model that has been opened */
typedef uint64_t motiongan_clip;   /**< handle of a motion in memory */
typedef uint64_t motiongan_stream; /**< handle of a crowd of characters of one model */

/** What a model is told, and what it can make. */
typedef int32_t motiongan_kind;
enum {
  MOTIONGAN_TEXT_WINDOW = 1, /**< text, CNN generator: clips of one length, no streams, no priors */
  MOTIONGAN_TEXT_STREAM = 2, /**< text, RNN generator: clips of any length, streams, priors */
  MOTIONGAN_CLASSES = 3      /**< classes: clips of any length and streams, which continue a prior, by default
                                one of the model's own, which shipped models keep */
};

/** What can be read of each joint in each frame. */
typedef int32_t motiongan_quantity;
enum {
  MOTIONGAN_LOCAL_ROTATIONS = 1, /**< x, y, z, w, relative to the parent; the root's in the world */
  MOTIONGAN_LOCAL_POSITIONS = 2, /**< x, y, z, in the parent's frame; the root's in the world */
  MOTIONGAN_GLOBAL_POSITIONS = 3 /**< x, y, z, in the world */
};

/* ---- the library */

/** MOTIONGAN_VERSION_STRING of the library that runs: "0.1.0". Its headers may have had another. */
MOTIONGAN_API const char* motiongan_version(void);

/** "MOTIONGAN_OK" and so on; "unknown status" for other numbers. */
MOTIONGAN_API const char* motiongan_status_name(motiongan_status status);

/** Why the last call of this thread that failed did so; "" if none did. Valid until the next call
 * of the thread. */
MOTIONGAN_API const char* motiongan_last_error(void);

/** Ends a model, clip or stream. */
MOTIONGAN_API motiongan_status motiongan_close(uint64_t handle);

/* ---- models */

/** How many trained models are installed: those that come with motiongan, and those in the folders of
 * MOTIONGAN_MODELS. */
MOTIONGAN_API motiongan_status motiongan_shipped_count(size_t* count);

/** The name of one of them, from 0, in alphabetical order, for motiongan_model_open(). Valid until the next
 * call of the thread. */
MOTIONGAN_API motiongan_status motiongan_shipped_name(size_t index, const char** name);

/** Opens a model file, the generator in the folder of a training run, or a shipped model by its name
 * ("cmu-text"). `device` selects the OpenCL device: "cpu", "gpu", a part of its name, "NAME:index"; NULL or
 * "": that of MOTIONGAN_DEVICE, else the best one. */
MOTIONGAN_API motiongan_status motiongan_model_open(const char* path, const char* device,
                                                    motiongan_model* model);

/** What the model is told, and what it can make. */
MOTIONGAN_API motiongan_status motiongan_model_kind(motiongan_model model, motiongan_kind* kind);

/** Frames per second of everything that the model makes. */
MOTIONGAN_API motiongan_status motiongan_model_rate(motiongan_model model, double* rate);

/** Metres per unit of length; 0: unknown. */
MOTIONGAN_API motiongan_status motiongan_model_unit(motiongan_model model, double* metres);

/** Frames that the model makes at once, and of its prior: a window of texts, a second of classes. */
MOTIONGAN_API motiongan_status motiongan_model_frames(motiongan_model model, size_t* frames);

/** How many words a model of texts knows, or how many classes a model of classes. */
MOTIONGAN_API motiongan_status motiongan_model_prompt_count(motiongan_model model, size_t* count);

/** Word or class number `index`, from 0. Other words are accepted in texts, and count as unknown. */
MOTIONGAN_API motiongan_status motiongan_model_prompt(motiongan_model model, size_t index,
                                                      const char** prompt);

/* ---- joints, of a model or a clip: parents come before children, joint 0 is the root */

/** How many joints each frame has. */
MOTIONGAN_API motiongan_status motiongan_joint_count(uint64_t model_or_clip, size_t* count);

/** The name of a joint. */
MOTIONGAN_API motiongan_status motiongan_joint_name(uint64_t model_or_clip, size_t joint, const char** name);

/** The index of each joint's parent, -1 for the root: [joints]. */
MOTIONGAN_API motiongan_status motiongan_joint_parents(uint64_t model_or_clip, int32_t* parents,
                                                       size_t length);

/** Where joints are in their parents' frames when nothing turns: [joints, 3]. */
MOTIONGAN_API motiongan_status motiongan_joint_offsets(uint64_t model_or_clip, float* offsets, size_t length);

/* ---- clips */

/** Makes a clip of `frames` frames; 0: motiongan_model_frames(), the only length of a MOTIONGAN_TEXT_WINDOW.
 * `prompt` is a text, or the name of a class. The same seed and sample give the same clip on the same device.
 * The clip continues the last frame of `prior`; the prior itself is not in it. 0: none, or for a model of
 * classes the second of its own that `sample` selects; fails if it keeps none. */
MOTIONGAN_API motiongan_status motiongan_clip_make(motiongan_model model, const char* prompt, size_t frames,
                                                   uint64_t seed, uint32_t sample, motiongan_clip prior,
                                                   motiongan_clip* clip);

/** Reads a motion file: BVH, GLB ("moves.glb#walk": one animation of several), AMC, NPZ of AMASS, CSV, NPY.
 * The clip has y up; a T-pose at its start is left out. As a prior it is scaled to the model's size where
 * they differ by more than half. */
MOTIONGAN_API motiongan_status motiongan_clip_read(const char* path, motiongan_clip* clip);

/** A clip of the model's joints from arrays, as motiongan_clip_get() writes them: rotations [frames, joints,
 * 4], which are normalised, and positions [frames, joints, 3], of which those of the first frame are the
 * lengths of the bones. Lengths are those of the arrays. */
MOTIONGAN_API motiongan_status motiongan_clip_from_arrays(motiongan_model model, double rate, size_t frames,
                                                          const float* rotations, size_t rotations_length,
                                                          const float* positions, size_t positions_length,
                                                          motiongan_clip* clip);

/** How many frames the clip has. */
MOTIONGAN_API motiongan_status motiongan_clip_frames(motiongan_clip clip, size_t* frames);

/** Frames per second. */
MOTIONGAN_API motiongan_status motiongan_clip_rate(motiongan_clip clip, double* rate);

/** Writes all frames to `out`, [frames, joints, 4 or 3]; `length` is how many floats `out` has room for. */
MOTIONGAN_API motiongan_status motiongan_clip_get(motiongan_clip clip, motiongan_quantity quantity,
                                                  float* out, size_t length);

/** Writes a file, whole or not at all: .bvh or .glb by its ending. */
MOTIONGAN_API motiongan_status motiongan_clip_write(motiongan_clip clip, const char* path);

/* ---- streams: any number of characters of one model, advanced together frame by frame */

/** How a character begins. Set everything that is not needed to 0. */
typedef struct motiongan_start {
  const char* prompt;   /**< a text, or the name of a class */
  uint64_t seed;        /**< of the noise */
  motiongan_clip prior; /**< motion that it continues from the last frame on, in its place. 0: none; for a
                           model of classes, one of its own */
  double x;             /**< where it starts instead, if `placed` */
  double z;             /**< the same */
  double yaw;           /**< and its direction, in radians about y */
  uint32_t sample;      /**< another sample of a seed is another motion */
  uint32_t placed;      /**< 0: as the prior says, else at the origin; 1: at x, z, yaw */
} motiongan_start;

/** For a model of kind MOTIONGAN_TEXT_STREAM or MOTIONGAN_CLASSES. */
MOTIONGAN_API motiongan_status motiongan_stream_create(motiongan_model model, motiongan_stream* stream);

/** Adds `count` characters, at most 65536 in a call, all or none, and writes a number for each to `ids`. They
 * move with the next step. Many in one call cost little more than one. */
MOTIONGAN_API motiongan_status motiongan_stream_add(motiongan_stream stream, const motiongan_start* starts,
                                                    size_t count, uint64_t* ids);

/** Ends a character, whose number is not used again. */
MOTIONGAN_API motiongan_status motiongan_stream_remove(motiongan_stream stream, uint64_t id);

/** Another text or class. A text acts from the frame after the next; a class from the character's next
 * second, since a model of classes makes a second at once. */
MOTIONGAN_API motiongan_status motiongan_stream_set_prompt(motiongan_stream stream, uint64_t id,
                                                           const char* prompt);

/** Advances all characters by one frame. If it fails, characters may be at different frames; what
 * motiongan_stream_get() gives remains valid. */
MOTIONGAN_API motiongan_status motiongan_stream_step(motiongan_stream stream);

/** How many characters the stream has. */
MOTIONGAN_API motiongan_status motiongan_stream_count(motiongan_stream stream, size_t* count);

/** The numbers of all characters, in the order in which they were added: [characters]. */
MOTIONGAN_API motiongan_status motiongan_stream_ids(motiongan_stream stream, uint64_t* ids, size_t length);

/** Writes the frame of the last step of `count` characters to `out`, [count, joints, 4 or 3]. `ids` NULL: of
 * all characters, in the order of motiongan_stream_ids(); `count` must be their number. `length` is how many
 * floats `out` has room for. Fails for a character that was added since the last step. */
MOTIONGAN_API motiongan_status motiongan_stream_get(motiongan_stream stream, const uint64_t* ids,
                                                    size_t count, motiongan_quantity quantity, float* out,
                                                    size_t length);

#ifdef __cplusplus
}
#endif

#endif /* MOTIONGAN_H */
