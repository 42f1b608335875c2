// Monitors, transcripts, plots and force reports: every reader gets every text.
#include "postproc/importers/reports/reports.h"
#include "tests/fuzz/fuzz_importer.h"

namespace {

template <typename Read>
void feed(const std::string& path, Read&& read) {
    try {
        (void)read(path);
    } catch (const underbody::core::Error&) {
        // Refused.
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const underbody::test::MemoryFile file(data, size);
    feed(file.path(), underbody::postproc::read_monitor);
    feed(file.path(), underbody::postproc::read_plot);
    feed(file.path(), underbody::postproc::read_force_reports);
    return 0;
}
