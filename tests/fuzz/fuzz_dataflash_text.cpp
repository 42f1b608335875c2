#include "tests/fuzz/fuzz_log.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    underbody::test::feed_log(underbody::dynamics::read_dataflash_text, data, size);
    return 0;
}
