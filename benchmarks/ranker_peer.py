#!/usr/bin/env python3
"""The rankers' training step in PyTorch: the work and the names of ranker_steps.hpp.

    ranker_peer.py speed [--models ranker]

prints a JSON object a line: name, ms (median), torch (its version)."""
import json
import statistics
import sys
import time

import torch
import torch.nn as nn
import torch.nn.functional as F

BATCH, FRAMES, DOF, VOCABULARY, WORDS, K = 64, 32, 69, 100, 6, 256


class Text(nn.Module):
    def __init__(self):
        super().__init__()
        self.embedding, self.lstm, self.proj = nn.Embedding(VOCABULARY, K), nn.LSTM(K, K, 2), nn.Linear(4 * K, K)

    def forward(self, words):  # [words, batch], all of one length
        _, (h, c) = self.lstm(self.embedding(words))
        return self.proj(torch.cat([h[0], h[1], c[0], c[1]], 1))


class Rnn(nn.Module):
    def __init__(self):
        super().__init__()
        self.text, self.pose, self.diff = Text(), nn.Linear(DOF, K), nn.Linear(DOF, K)
        self.lstm, self.motion, self.combine = nn.LSTM(K, K, 2), nn.Linear(K, K), nn.Linear(2 * K, K)

    def embed(self, x):  # [frames, batch, dof]
        h, _ = self.lstm(self.diff(x[1:] - x[:-1]))
        return self.combine(torch.cat([self.motion(h).mean(0), self.pose(x).mean(0)], 1))


class Cnn(nn.Module):
    def __init__(self):
        super().__init__()
        self.text, self.encode = Text(), nn.Conv1d(DOF, K, 1)
        self.levels = nn.ModuleList(
            nn.ModuleList(nn.Conv1d(K, K, 3, padding=1) for _ in range(2)) for _ in range(FRAMES.bit_length() - 1))

    def embed(self, x):
        h = self.encode(x.permute(1, 2, 0))
        for first, second in self.levels:
            h = F.avg_pool1d(h, 2) + second(F.relu(F.avg_pool1d(first(h), 2)))
        return h[:, :, 0]


def median_ms(model):
    adam = torch.optim.Adam(model.parameters(), lr=1e-4)
    x, right = torch.randn(FRAMES, BATCH, DOF), torch.arange(BATCH)
    words = (torch.arange(BATCH * WORDS) * 7 % VOCABULARY).reshape(BATCH, WORDS).T.contiguous()

    def step():
        loss = F.cross_entropy(F.normalize(model.embed(x), dim=1) @ model.text(words).T, right)
        adam.zero_grad()
        loss.backward()
        adam.step()

    for _ in range(3):
        step()
    times, begin = [], time.perf_counter()
    while len(times) < 7 or time.perf_counter() - begin < 4:
        start = time.perf_counter()
        step()
        times.append(time.perf_counter() - start)
    return 1e3 * statistics.median(times)


if __name__ == '__main__':
    if len(sys.argv) < 2 or sys.argv[1] != 'speed':
        sys.exit(__doc__)
    torch.manual_seed(1)
    for name, model in (('rnn', Rnn()), ('cnn', Cnn())):
        print(json.dumps({'name': f'{name}_ranker_step_b64', 'ms': median_ms(model), 'torch': torch.__version__}),
              flush=True)
