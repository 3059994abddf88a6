"""Reports of the kernel benchmarks, which the C++ files here measure."""
