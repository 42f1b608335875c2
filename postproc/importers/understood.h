// An error of an importer says what had been understood before it.
#pragma once

#include <string>

#include "core/error.h"

namespace underbody::postproc {

/// Calls `read`; an InputError of it goes on with "; understood so far: ..." behind its message.
template <typename Read, typename Understood>
auto telling(Read&& read, Understood&& understood) {
    try {
        return read();
    } catch (const core::InputError& error) {
        const bool of_content = error.kind() == "format" || error.kind() == "parse";
        if (!of_content || error.message().find("understood so far") != std::string::npos) {
            throw;
        }
        throw core::InputError(error.kind(), error.message() + "; understood so far: " + understood(), error.place(),
                               error.hint());
    }
}

}  // namespace underbody::postproc
