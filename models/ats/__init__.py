"""ATS-S and ATS-SP (1991): the point automatic train stop and its successor with speed patterns, as executable models.

Distances in metres along the line in the direction of running, speeds in m/s, times in seconds, all exact.  Timers run
on time stamps: a step is told how long ago the last one was, so nothing is counted in cycles.
Source: Hasegawa and Nakamura, Train Control by on-board Microcomputers (1991).
"""
