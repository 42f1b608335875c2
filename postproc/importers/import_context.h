// An error of an importer says what had been understood before it.
#pragma once

#include <string>
#include <vector>

#include "postproc/field/import_error.h"

namespace underbody::postproc {

/// Calls `read`; what it finds wrong with the content goes on as an ImportError with the words of `understood`, unless
/// somebody further inside, who knew more, said it already.
template <typename Read, typename Understood>
auto telling(Read&& read, Understood&& understood) {
    try {
        return read();
    } catch (const ImportError&) {
        throw;
    } catch (const core::InputError& error) {
        if (error.kind() == "file" || error.kind() == "zone" || error.kind() == "missing" || error.kind() == "unit") {
            throw;  // not the content is wrong, but what was asked for, or it lacks something
        }
        throw ImportError(error, understood());
    }
}

/// "a, b, c ..." of at most `most` names.
inline std::string listed(const std::vector<std::string>& names, std::size_t most = 12) {
    std::string text;
    for (std::size_t i = 0; i < names.size() && i < most; ++i) {
        text += (i > 0 ? ", " : "") + names[i];
    }
    return text + (names.size() > most ? " ..." : "");
}

}  // namespace underbody::postproc
