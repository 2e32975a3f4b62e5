# ctest runs this one, as it needs nothing but Python.
collect_ignore = ["layers_test.py"]
