"""Characters of a model, frame by frame, from Python: ctypes and numpy, nothing to build.

    python3 stream.py libmotiongan.so MODEL PROMPT [PRIOR]

MODEL is a model file or the folder of a run; PRIOR is a clip, which a model of classes continues.
"""
import ctypes as c
import sys

import numpy as np

LOCAL_ROTATIONS, LOCAL_POSITIONS, GLOBAL_POSITIONS = 1, 2, 3
FLOATS = c.POINTER(c.c_float)


class Start(c.Structure):
    """motiongan_start"""

    _fields_ = [("prompt", c.c_char_p), ("seed", c.c_uint64), ("prior", c.c_uint64), ("x", c.c_double),
                ("z", c.c_double), ("yaw", c.c_double), ("sample", c.c_uint32), ("placed", c.c_uint32)]


# The arguments of the functions used here. Without them ctypes would pass integers of 32 bits.
SIGNATURES = {
    "motiongan_model_open": [c.c_char_p, c.c_char_p, c.POINTER(c.c_uint64)],
    "motiongan_clip_read": [c.c_char_p, c.POINTER(c.c_uint64)],
    "motiongan_joint_count": [c.c_uint64, c.POINTER(c.c_size_t)],
    "motiongan_joint_name": [c.c_uint64, c.c_size_t, c.POINTER(c.c_char_p)],
    "motiongan_model_rate": [c.c_uint64, c.POINTER(c.c_double)],
    "motiongan_stream_create": [c.c_uint64, c.POINTER(c.c_uint64)],
    "motiongan_stream_add": [c.c_uint64, c.POINTER(Start), c.c_size_t, c.POINTER(c.c_uint64)],
    "motiongan_stream_step": [c.c_uint64],
    "motiongan_stream_get": [c.c_uint64, c.POINTER(c.c_uint64), c.c_size_t, c.c_int32, FLOATS, c.c_size_t],
    "motiongan_close": [c.c_uint64],
}


class Library:
    """Calls motiongan_NAME(...) as library.NAME(...); raises RuntimeError where a call fails."""

    def __init__(self, path):
        self._dll = c.CDLL(path)
        self._dll.motiongan_last_error.restype = c.c_char_p
        for name, arguments in SIGNATURES.items():
            getattr(self._dll, name).argtypes = arguments
            getattr(self._dll, name).restype = c.c_int32

    def __getattr__(self, name):
        function = getattr(self._dll, "motiongan_" + name)

        def checked(*arguments):
            if function(*arguments) != 0:
                raise RuntimeError(self._dll.motiongan_last_error().decode("utf-8", "replace"))

        return checked

    def read(self, name, kind, *arguments):
        """The one value that a call writes to its last argument."""
        value = kind()
        getattr(self, name)(*arguments, c.byref(value))
        return value.value


def main(library, model_path, prompt, prior_path=None):
    lib = Library(library)
    model = lib.read("model_open", c.c_uint64, model_path.encode(), None)
    prior = lib.read("clip_read", c.c_uint64, prior_path.encode()) if prior_path else 0
    joints = lib.read("joint_count", c.c_size_t, model)
    rate = lib.read("model_rate", c.c_double, model)
    names = [lib.read("joint_name", c.c_char_p, model, j).decode() for j in range(joints)]
    print(f"{joints} joints from {names[0]} to {names[-1]}, {rate:g} frames per second")

    stream = lib.read("stream_create", c.c_uint64, model)
    count = 10
    starts = (Start * count)(*(Start(prompt.encode(), 1, prior, sample=i) for i in range(count)))
    ids = (c.c_uint64 * count)()
    lib.stream_add(stream, starts, count, ids)

    # One array, written anew for each frame.
    positions = np.empty((count, joints, 3), np.float32)
    frames = []
    for _ in range(int(4 * rate)):
        lib.stream_step(stream)
        lib.stream_get(stream, None, count, GLOBAL_POSITIONS, positions.ctypes.data_as(FLOATS), positions.size)
        frames.append(positions.copy())
    motion = np.stack(frames)  # [frames, characters, joints, 3]
    speed = np.linalg.norm(np.diff(motion[:, :, 0], axis=0), axis=-1).mean() * rate
    print(f"{motion.shape[0]} frames of {count} characters; their roots move {speed:.1f} units per second on average")
    if not np.isfinite(motion).all():
        raise SystemExit("positions are not finite")
    for handle in (stream, model, *([prior] if prior else [])):
        lib.close(handle)


if __name__ == "__main__":
    if len(sys.argv) not in (4, 5):
        sys.exit(__doc__)
    main(*sys.argv[1:])
