"""motiongan: generative models of human motion, by the C interface of libmotiongan.

    import motiongan, numpy

    model = motiongan.Model("cmu-stream")                         # a shipped model, a run's folder or a model file
    model.make("walk", frames=300, seed=7).write("walk.bvh")      # a clip

    stream = model.stream()                                       # characters, frame by frame
    ids = stream.add([motiongan.Start("walk", sample=i) for i in range(10)])
    stream.step()
    frame = numpy.asarray(stream.get(motiongan.Quantity.GLOBAL_POSITIONS))     # [characters, joints, 3]

Arrays are memoryviews of 32-bit floats with a shape, of which numpy.asarray() makes arrays without a copy;
numpy itself is not needed. What fails raises motiongan.Error. Models, clips and streams are closed when they are
no longer used, or by close() or `with`. Axes, units and threads: see motiongan.h.
"""
import ctypes as _c
import dataclasses as _dataclasses
import enum as _enum
import math as _math
import os as _os

from . import _library
from ._library import Error

__all__ = ["Clip", "Error", "Kind", "Model", "Quantity", "Start", "Stream", "__version__", "shipped_models"]
__version__ = _library.version()


def shipped_models():
    """The names of the trained models that are installed, for Model()."""
    count = _library.ask("shipped_count", _c.c_size_t)
    return [_library.ask("shipped_name", _c.c_char_p, i).decode() for i in range(count)]


class Kind(_enum.IntEnum):
    """What a model makes."""

    TEXT_WINDOW = 1  # of texts: clips of one length, no streams, no priors
    TEXT_STREAM = 2  # of texts: clips of any length, streams, priors
    CLASSES = 3  # of classes: clips of any length and streams, which continue a prior or a second of its own


class Quantity(_enum.IntEnum):
    """What can be read of each joint in each frame."""

    LOCAL_ROTATIONS = 1  # x, y, z, w, relative to the parent; the root's in the world
    LOCAL_POSITIONS = 2  # x, y, z, in the parent's frame; the root's in the world
    GLOBAL_POSITIONS = 3  # x, y, z, in the world

    @property
    def width(self):
        """Numbers for each joint."""
        return 4 if self is Quantity.LOCAL_ROTATIONS else 3


def _new_array(*shape):
    """A memoryview of floats; flat where it is empty, since those have no other shape."""
    view = memoryview(bytearray(4 * _math.prod(shape)))
    return view.cast("f", shape) if len(view) else view.cast("f")


def _floats(view):
    """The floats of a writable buffer for a call, and their number."""
    view = memoryview(view)
    if view.format != "f" or not view.c_contiguous:
        raise TypeError(f"found a buffer of format {view.format!r}, expected contiguous floats of 32 bits")
    count = view.nbytes // 4
    return (_c.c_float * count).from_buffer(view), count


def _read_floats(values):
    """A copy of the floats of a buffer for a call, and their number."""
    return _floats(memoryview(bytearray(memoryview(values).cast("B"))).cast(memoryview(values).format))


class _Handle:
    """What a handle of the library stands for."""

    def __init__(self, handle):
        self._handle = handle

    def close(self):
        """Ends it. Using it afterwards raises Error; closing it again does nothing."""
        handle, self._handle = self._handle, 0
        if handle:
            _library.call("close", handle)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def __del__(self):
        if getattr(self, "_handle", 0):
            self.close()


class _Skeleton(_Handle):
    """Joints: parents come before children, joint 0 is the root."""

    @property
    def joint_count(self):
        return _library.ask("joint_count", _c.c_size_t, self._handle)

    @property
    def joints(self):
        """The names of the joints."""
        return [_library.ask("joint_name", _c.c_char_p, self._handle, i).decode() for i in range(self.joint_count)]

    @property
    def parents(self):
        """The index of each joint's parent, -1 for the root."""
        count = self.joint_count
        parents = (_c.c_int32 * count)()
        _library.call("joint_parents", self._handle, parents, count)
        return list(parents)

    @property
    def offsets(self):
        """Where joints are in their parents' frames when nothing turns: [joints, 3]."""
        out = _new_array(self.joint_count, 3)
        _library.call("joint_offsets", self._handle, *_floats(out))
        return out


class Clip(_Skeleton):
    """A motion: made by a model, read from a file, or made of arrays."""

    @classmethod
    def read(cls, path):
        """A clip from a motion file: BVH, GLB, AMC, NPZ of AMASS, CSV, NPY."""
        return cls(_library.ask("clip_read", _library.Handle, _os.fsencode(path)))

    @property
    def frames(self):
        return _library.ask("clip_frames", _c.c_size_t, self._handle)

    @property
    def rate(self):
        """Frames per second."""
        return _library.ask("clip_rate", _c.c_double, self._handle)

    def get(self, quantity):
        """All frames: [frames, joints, 4 or 3]."""
        quantity = Quantity(quantity)
        out = _new_array(self.frames, self.joint_count, quantity.width)
        _library.call("clip_get", self._handle, quantity, *_floats(out))
        return out

    def write(self, path):
        """Writes a .bvh or .glb file."""
        _library.call("clip_write", self._handle, _os.fsencode(path))


@_dataclasses.dataclass
class Start:
    """How a character begins: its text or class, its noise, a Clip that it continues, and where, if not as the clip
    says: (x, z, yaw), yaw in radians about y."""

    prompt: str
    seed: int = 1
    sample: int = 0
    prior: Clip | None = None
    place: tuple | None = None

    def _struct(self):
        x, z, yaw = self.place or (0, 0, 0)
        return _library.Start(self.prompt.encode(), self.seed, self.prior._handle if self.prior else 0, x, z, yaw,
                              self.sample, self.place is not None)


class Stream(_Handle):
    """Any number of characters of one model, which advance together frame by frame; from Model.stream()."""

    def __init__(self, handle, joint_count):
        super().__init__(handle)
        self._joint_count = joint_count

    def add(self, starts):
        """Adds a character for each Start, all or none; their numbers. They move with the next step."""
        starts = list(starts)
        ids = (_c.c_uint64 * len(starts))()
        structs = (_library.Start * len(starts))(*(start._struct() for start in starts))
        _library.call("stream_add", self._handle, structs, len(starts), ids)
        return list(ids)

    def remove(self, character):
        _library.call("stream_remove", self._handle, character)

    def set_prompt(self, character, prompt):
        """Another text or class: from the frame after the next, or from the character's next second."""
        _library.call("stream_set_prompt", self._handle, character, prompt.encode())

    def step(self):
        """Advances all characters by one frame."""
        _library.call("stream_step", self._handle)

    def __len__(self):
        return _library.ask("stream_count", _c.c_size_t, self._handle)

    @property
    def ids(self):
        """The numbers of all characters, in the order in which they were added."""
        count = len(self)
        ids = (_c.c_uint64 * count)()
        _library.call("stream_ids", self._handle, ids, count)
        return list(ids)

    def get(self, quantity, ids=None, out=None):
        """The frame of the last step: [characters, joints, 4 or 3], of all characters or of those listed. `out` is a
        buffer of floats to write into, such as a numpy array of float32, which is returned instead of a new one."""
        quantity = Quantity(quantity)
        count = len(self) if ids is None else len(ids)
        if out is None:
            out = _new_array(count, self._joint_count, quantity.width)
        listed = None if ids is None else (_c.c_uint64 * count)(*ids)
        _library.call("stream_get", self._handle, listed, count, quantity, *_floats(out))
        return out


class Model(_Skeleton):
    """A trained model."""

    def __init__(self, path, device=None):
        """Opens a model file, a run's folder or a shipped model by its name. The device is "cpu", "gpu", a part of its name or "NAME:index"."""
        super().__init__(_library.ask("model_open", _library.Handle, _os.fsencode(path), device and device.encode()))

    @property
    def kind(self):
        return Kind(_library.ask("model_kind", _c.c_int32, self._handle))

    @property
    def rate(self):
        """Frames per second of all that it makes."""
        return _library.ask("model_rate", _c.c_double, self._handle)

    @property
    def unit(self):
        """Metres per unit of length; 0: unknown."""
        return _library.ask("model_unit", _c.c_double, self._handle)

    @property
    def frames(self):
        """Frames that it makes at once: a window of texts, a second of classes."""
        return _library.ask("model_frames", _c.c_size_t, self._handle)

    @property
    def prompts(self):
        """The words that it knows, or its classes."""
        count = _library.ask("model_prompt_count", _c.c_size_t, self._handle)
        return [_library.ask("model_prompt", _c.c_char_p, self._handle, i).decode() for i in range(count)]

    def make(self, prompt, frames=0, seed=1, sample=0, prior=None):
        """A Clip for a text or a class; 0 frames: as many as it makes at once. It continues `prior`, a Clip, which
        a Kind.TEXT_WINDOW cannot use; without one a model of classes continues a second that it keeps itself."""
        return Clip(_library.ask("clip_make", _library.Handle, self._handle, prompt.encode(), frames, seed, sample,
                                 prior._handle if prior else 0))

    def clip(self, rotations, positions, rate=None):
        """A Clip of this model's joints, of floats as Clip.get() gives them: local rotations [frames, joints, 4] and
        local positions [frames, joints, 3]. The rate is the model's unless given."""
        rotations, rotation_count = _read_floats(rotations)
        positions, position_count = _read_floats(positions)
        frames = rotation_count // (4 * self.joint_count)
        return Clip(_library.ask("clip_from_arrays", _library.Handle, self._handle, rate or self.rate, frames, rotations,
                                 rotation_count, positions, position_count))

    def stream(self):
        """A Stream without characters. It needs the model no longer."""
        return Stream(_library.ask("stream_create", _library.Handle, self._handle), self.joint_count)
