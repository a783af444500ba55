"""Data -> checkpoint: training of every network."""

import os

# Threads of OpenMP spin while they wait for one another. Beside other work on the same cores a step
# of lists costs 2.8 s of processor time so, and 0.25 s where they sleep. Read once, by torch.
os.environ.setdefault("OMP_WAIT_POLICY", "PASSIVE")
