"""Messages and stubs of the API, generated from `proto/mane/v1` when the package is built."""
