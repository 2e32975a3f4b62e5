"""Experiments of [SH06], [AUK92] and of rod mechanics on a running server, and what theory says.

Each module has `run(client, report, quick)`: it plays its scene over the public API, in LOCKSTEP or
by rest shapes, hands figures and numbers to the `Report`, and compares them with theory that it
works out itself. `mane experiment NAME` runs one. Same server, same numbers.
"""
