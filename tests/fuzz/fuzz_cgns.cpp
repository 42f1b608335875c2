#include <hdf5.h>

#include "tests/fuzz/fuzz_importer.h"

namespace underbody::postproc {
Importer cgns_importer();
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const auto importer = underbody::postproc::cgns_importer();
    underbody::test::feed(importer, data, size);
    return 0;
}

/// Memory that the library hands out again is larger than what was asked for: behind its end nobody would see a step,
/// in the process of the trial or in this one, as it happens.
extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/) {
    H5set_free_list_limits(0, 0, 0, 0, 0, 0);
    return 0;
}
