"""Characters of a model, frame by frame, from Python.

    python3 stream.py MODEL PROMPT [PRIOR]

MODEL is a model file or the folder of a run; PRIOR is a clip, which a model of classes continues.
"""
import sys

import motiongan
import numpy as np
from motiongan import Clip, Model, Quantity, Start


def main(model_path, prompt, prior_path=None):
    model = Model(model_path)
    prior = Clip.read(prior_path) if prior_path else None
    names = model.joints
    print(f"motiongan {motiongan.__version__}: {len(names)} joints from {names[0]} to {names[-1]}, "
          f"{model.rate:g} frames per second")

    count = 10
    stream = model.stream()
    stream.add([Start(prompt, sample=i, prior=prior) for i in range(count)])

    # One array, written anew for each frame.
    positions = np.empty((count, len(names), 3), np.float32)
    frames = []
    for _ in range(int(4 * model.rate)):
        stream.step()
        frames.append(stream.get(Quantity.GLOBAL_POSITIONS, out=positions).copy())
    motion = np.stack(frames)  # [frames, characters, joints, 3]
    speed = np.linalg.norm(np.diff(motion[:, :, 0], axis=0), axis=-1).mean() * model.rate
    print(f"{motion.shape[0]} frames of {count} characters; their roots move {speed:.1f} units per second on average")
    if not np.isfinite(motion).all():
        raise SystemExit("positions are not finite")


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    main(*sys.argv[1:])
