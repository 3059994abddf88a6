"""Reports of the benchmarks of the kernels; what is measured is in the C++ files here."""
