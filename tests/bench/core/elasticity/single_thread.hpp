#pragma once

namespace palpate::bench {

/// To be called first in main(). CHOLMOD's supernodal kernel opens four OpenMP threads whatever
/// OMP_NUM_THREADS says, and the BLAS beneath it starts its own; both read what stops them from the
/// environment before main() runs. Sets it and starts the program anew, once.
void run_libraries_in_one_thread(char** argv);

}  // namespace palpate::bench
