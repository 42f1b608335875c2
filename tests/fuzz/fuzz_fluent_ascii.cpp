#include "tests/fuzz/fuzz_importer.h"

namespace underbody::postproc {
Importer fluent_ascii_importer();
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const auto importer = underbody::postproc::fluent_ascii_importer();
    underbody::test::feed(importer, data, size);
    return 0;
}
