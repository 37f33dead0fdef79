"""Position of a train: axle pulses, slip and slide, absolute code from five balises, correction at every balise.

Distances in m in the direction of running, speeds in m/s, times in s.
Source: axle pulses, five reference balises with 9,139 combinations, correction at balises at most about 1 km apart [P];
all other numbers [A].
"""
