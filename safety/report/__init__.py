"""Reports: one results document in; HTML, SVG, JUnit and terminal text out. How a result came about is unknown here.

results.py loads, merges and writes documents; standing.py judges each result and gives the exit code; gaps.py finds
what is not shown; folder.py writes the report folder and checks that a committed one is fresh.
"""
