// What an error costs, by sampling: printed after the benchmarks.
#pragma once
void printSamplings();
