#include "postproc/importers/mesh/buffer.h"

#include <sys/mman.h>

namespace underbody::postproc {

void* take_memory(std::size_t bytes) {
    constexpr std::size_t huge_page = std::size_t{2} << 20;
    void* memory = nullptr;
    if (bytes < 2 * huge_page) {
        memory = std::malloc(bytes);
    } else if (::posix_memalign(&memory, huge_page, bytes) == 0) {
        // Advice: a system that has none gives small pages. The rest at the end would be a page mostly unused.
        ::madvise(memory, bytes / huge_page * huge_page, MADV_HUGEPAGE);
    }
    if (memory == nullptr) {
        throw std::bad_alloc();
    }
    return memory;
}

}  // namespace underbody::postproc
