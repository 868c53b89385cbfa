"""The Python module with a model of each kind. MOTIONGAN_MODELS is a folder that c_models wrote."""
import array
import math
import os
import pathlib
import tempfile
import unittest

import motiongan
from motiongan import Clip, Kind, Model, Quantity, Start

MODELS = pathlib.Path(os.environ["MOTIONGAN_MODELS"])


def opened(name):
    return Model(MODELS / f"{name}.safetensors")


class Models(unittest.TestCase):
    def test_what_models_say(self):
        for name, kind in (("window", Kind.TEXT_WINDOW), ("rnn", Kind.TEXT_STREAM), ("classes", Kind.CLASSES)):
            with opened(name) as model:
                self.assertIs(model.kind, kind)
                self.assertEqual(model.rate, 10)
                self.assertGreaterEqual(model.unit, 0)
                self.assertIn("run", model.prompts)
                self.assertEqual(len(model.joints), model.joint_count)
                self.assertTrue(all(parent < joint for joint, parent in enumerate(model.parents)))
                self.assertEqual(model.offsets.shape, (model.joint_count, 3))

    def test_shipped(self):
        names = motiongan.shipped_models()
        self.assertEqual(names, sorted(names))
        self.assertIn("cmu-actions", names)
        with Model("cmu-actions") as model:
            clip = model.make("walk", frames=40)  # continues a second of the model's own
            self.assertEqual(clip.get(Quantity.GLOBAL_POSITIONS).shape, (40, model.joint_count, 3))

    def test_versions(self):
        self.assertRegex(motiongan.__version__, r"^\d+\.\d+\.\d+$")


class Clips(unittest.TestCase):
    def test_made_written_and_read(self):
        prior = Clip.read(MODELS / "prior.bvh")
        with tempfile.TemporaryDirectory() as folder:
            for name in ("window", "rnn", "classes"):
                model = opened(name)
                clip = model.make("run", seed=3, prior=prior if model.kind is Kind.CLASSES else None)
                self.assertEqual(clip.frames, model.frames)
                self.assertEqual(clip.rate, model.rate)
                path = pathlib.Path(folder) / "clip.bvh"
                clip.write(path)
                again = Clip.read(path)
                self.assertEqual(again.joints, clip.joints)
                self.assertEqual(again.get(Quantity.GLOBAL_POSITIONS).shape, (clip.frames, model.joint_count, 3))

    def test_arrays_give_the_clip_back(self):
        model = opened("rnn")
        made = model.make("run", frames=20)
        rotations, positions = made.get(Quantity.LOCAL_ROTATIONS), made.get(Quantity.LOCAL_POSITIONS)
        copied = model.clip(rotations, positions)
        for before, after in zip(made.get(Quantity.GLOBAL_POSITIONS).tolist(),
                                 copied.get(Quantity.GLOBAL_POSITIONS).tolist()):
            self.assertLess(max(math.dist(a, b) for a, b in zip(before, after)), 1e-2)
        with self.assertRaises(TypeError):
            model.clip(array.array("d", [0.0]), positions)

    def test_seeds(self):
        model = opened("rnn")
        clips = [model.make("run", frames=9, seed=seed).get(Quantity.LOCAL_ROTATIONS).tolist() for seed in (1, 1, 2)]
        self.assertEqual(clips[0], clips[1])
        self.assertNotEqual(clips[0], clips[2])


class Streams(unittest.TestCase):
    def test_characters(self):
        model, prior = opened("classes"), Clip.read(MODELS / "prior.bvh")
        stream = model.stream()
        self.assertEqual(len(stream.get(Quantity.LOCAL_ROTATIONS)), 0)
        first, second = stream.add([Start("run", prior=prior), Start("run", sample=1, prior=prior, place=(200, 0, 0))])
        model.close()
        prior.close()
        stream.set_prompt(first, "jump")
        for _ in range(15):
            stream.step()
        self.assertEqual(stream.ids, [first, second])
        frame = stream.get(Quantity.GLOBAL_POSITIONS)
        self.assertEqual(frame.shape[0], 2)
        self.assertTrue(all(map(math.isfinite, memoryview(frame).cast("B").cast("f"))))
        stream.remove(first)
        self.assertEqual(stream.get(Quantity.GLOBAL_POSITIONS, [second]).tolist(), frame.tolist()[1:])
        out = array.array("f", bytes(4 * frame.shape[1] * 4))
        self.assertIs(stream.get(Quantity.LOCAL_ROTATIONS, out=out), out)
        self.assertAlmostEqual(math.hypot(*out[:4]), 1, places=5)

    def test_numpy(self):
        try:
            import numpy
        except ImportError:
            self.skipTest("there is no numpy; on Debian: apt-get install python3-numpy")
        with opened("rnn").stream() as stream:
            stream.add([Start("run"), Start("jump")])
            stream.step()
            view = numpy.asarray(stream.get(Quantity.LOCAL_POSITIONS))
            out = numpy.empty(view.shape, numpy.float32)
            stream.get(Quantity.LOCAL_POSITIONS, out=out)
            self.assertTrue((view == out).all())
            with self.assertRaises(TypeError):
                stream.get(Quantity.LOCAL_POSITIONS, out=numpy.empty(view.shape))


class Errors(unittest.TestCase):
    def test_statuses(self):
        with self.assertRaisesRegex(motiongan.Error, "no such file") as caught:
            Model("no such file")
        self.assertEqual(caught.exception.status, "MOTIONGAN_FAILED")
        window = opened("window")
        with self.assertRaisesRegex(motiongan.Error, "CNN generator"):
            window.stream()
        window.close()
        window.close()
        with self.assertRaises(motiongan.Error) as caught:
            window.make("run")
        self.assertEqual(caught.exception.status, "MOTIONGAN_INVALID_HANDLE")


if __name__ == "__main__":
    unittest.main()
