#include "core/parallel.h"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <memory>

#include "core/inputs.h"

namespace underbody::core {

namespace {
std::unique_ptr<tbb::global_control>& limit() {
    static std::unique_ptr<tbb::global_control> control;
    return control;
}
}  // namespace

void set_threads(int count) {
    limit().reset();
    if (count > 0) {
        limit() = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                        static_cast<std::size_t>(count));
    }
}

int threads() {
    return static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

void parallel_blocks(std::size_t count, std::size_t block, const std::function<void(std::size_t, std::size_t)>& body,
                     Progress& progress) {
    block = std::max<std::size_t>(1, block);
    const std::size_t blocks = (count + block - 1) / block;
    const RecordInputs* const scope = InputScope::current();
    // Whoever waits for a loop within a loop does not take up a part of the outer one meanwhile: what a part holds, a
    // lock or a claim, would be held while it waits for what another holds. A loop within a loop does all its parts or
    // throws: without a context of its own it would end early, without a word, when another part of the outer loop
    // throws, and its caller would go on with what is half done.
    tbb::task_group_context own(tbb::task_group_context::isolated);
    tbb::this_task_arena::isolate([&] {
        tbb::parallel_for(
            std::size_t{0}, blocks,
            [&](std::size_t i) {
                const InputScope inputs(scope);  // what any thread reads in the loop, the caller reads
                progress.check();
                body(i * block, std::min(count, (i + 1) * block));
            },
            tbb::simple_partitioner(), own);
    });
    progress.check();
}

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body, Progress& progress) {
    parallel_blocks(
        count, 1, [&](std::size_t begin, std::size_t) { body(begin); }, progress);
}

}  // namespace underbody::core
