"""libmotiongan by ctypes: the functions of motiongan.h, with errors as exceptions."""
import ctypes as c
import ctypes.util
import os
import pathlib

Handle = c.c_uint64


class Start(c.Structure):
    """motiongan_start"""

    _fields_ = [("prompt", c.c_char_p), ("seed", c.c_uint64), ("prior", Handle), ("x", c.c_double),
                ("z", c.c_double), ("yaw", c.c_double), ("sample", c.c_uint32), ("placed", c.c_uint32)]


_FLOATS = c.POINTER(c.c_float)
_SIZE = c.POINTER(c.c_size_t)
_DOUBLE = c.POINTER(c.c_double)
_NEW = c.POINTER(Handle)
_TEXT = c.POINTER(c.c_char_p)

# The arguments of each function that returns a status. Without them ctypes would pass integers of 32 bits.
_SIGNATURES = {
    "close": [Handle],
    "shipped_count": [_SIZE],
    "shipped_name": [c.c_size_t, _TEXT],
    "model_open": [c.c_char_p, c.c_char_p, _NEW],
    "model_kind": [Handle, c.POINTER(c.c_int32)],
    "model_rate": [Handle, _DOUBLE],
    "model_unit": [Handle, _DOUBLE],
    "model_frames": [Handle, _SIZE],
    "model_prompt_count": [Handle, _SIZE],
    "model_prompt": [Handle, c.c_size_t, _TEXT],
    "joint_count": [Handle, _SIZE],
    "joint_name": [Handle, c.c_size_t, _TEXT],
    "joint_parents": [Handle, c.POINTER(c.c_int32), c.c_size_t],
    "joint_offsets": [Handle, _FLOATS, c.c_size_t],
    "clip_make": [Handle, c.c_char_p, c.c_size_t, c.c_uint64, c.c_uint32, Handle, _NEW],
    "clip_read": [c.c_char_p, _NEW],
    "clip_from_arrays": [Handle, c.c_double, c.c_size_t, _FLOATS, c.c_size_t, _FLOATS, c.c_size_t, _NEW],
    "clip_frames": [Handle, _SIZE],
    "clip_rate": [Handle, _DOUBLE],
    "clip_get": [Handle, c.c_int32, _FLOATS, c.c_size_t],
    "clip_write": [Handle, c.c_char_p],
    "stream_create": [Handle, _NEW],
    "stream_add": [Handle, c.POINTER(Start), c.c_size_t, c.POINTER(c.c_uint64)],
    "stream_remove": [Handle, c.c_uint64],
    "stream_set_prompt": [Handle, c.c_uint64, c.c_char_p],
    "stream_step": [Handle],
    "stream_count": [Handle, _SIZE],
    "stream_ids": [Handle, c.POINTER(c.c_uint64), c.c_size_t],
    "stream_get": [Handle, c.POINTER(c.c_uint64), c.c_size_t, c.c_int32, _FLOATS, c.c_size_t],
}


class Error(RuntimeError):
    """A call that failed; `status` is the name of its motiongan_status, such as "MOTIONGAN_FAILED"."""

    def __init__(self, status, message):
        super().__init__(message)
        self.status = status


def _load():
    """The library of MOTIONGAN_LIBRARY, else the one in this package, else the one that is installed."""
    beside = pathlib.Path(__file__).with_name("libmotiongan.so")
    path = os.environ.get("MOTIONGAN_LIBRARY") or (str(beside) if beside.exists() else None)
    path = path or ctypes.util.find_library("motiongan")
    if path is None:
        raise ImportError("libmotiongan.so was not found; MOTIONGAN_LIBRARY may name it")
    dll = c.CDLL(path)
    for name in ("version", "status_name", "last_error"):
        getattr(dll, "motiongan_" + name).restype = c.c_char_p
    for name, arguments in _SIGNATURES.items():
        function = getattr(dll, "motiongan_" + name)
        function.argtypes = arguments
        function.restype = c.c_int32
    return dll


_dll = _load()


def version():
    """The version of the library."""
    return _dll.motiongan_version().decode()


def call(name, *arguments):
    """motiongan_NAME(arguments); raises Error where it fails."""
    status = getattr(_dll, "motiongan_" + name)(*arguments)
    if status != 0:
        raise Error(_dll.motiongan_status_name(status).decode(),
                    _dll.motiongan_last_error().decode("utf-8", "replace"))


def ask(name, kind, *arguments):
    """The value that a call writes to its last argument."""
    value = kind()
    call(name, *arguments, c.byref(value))
    return value.value
