#include "tests/fuzz/fuzz_importer.h"
#include "tests/fuzz/fuzz_log.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const underbody::test::MemoryFile file(data, size);
    underbody::test::AllRows sink;
    try {
        (void)underbody::dynamics::read_sqlite_bag(file.path(), sink, underbody::core::Progress::none());
    } catch (const underbody::core::Error&) {
        // Refused.
    }
    return 0;
}
