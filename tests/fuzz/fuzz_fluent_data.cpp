// Solution data beside a case that is whole.
#include "tests/fuzz/fuzz_importer.h"

namespace underbody::postproc {
Importer fluent_legacy_importer();
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const auto importer = underbody::postproc::fluent_legacy_importer();
    underbody::postproc::ReadOptions options;
    options.companion = UNDERBODY_TEST_DATA "/fluent_legacy/ascii.cas";
    underbody::test::feed(importer, data, size, options);
    return 0;
}
