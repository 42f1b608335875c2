// An error of an importer, with what it had understood of the file before.
#pragma once

#include <string>

#include "core/error.h"

namespace underbody::postproc {

/// Thrown by `read_field` for every fault in a file's content. The message ends with what was understood.
class ImportError : public core::InputError {
public:
    ImportError(const core::InputError& error, std::string understood)
        : core::InputError(error.kind(), error.message() + "; understood so far: " + understood, error.place(),
                           error.hint()),
          understood_(std::move(understood)) {}

    /// "12 sections, nodes 8 of 8, faces 0 of 24, cells 0 of 5, zones hull, ground"
    [[nodiscard]] const std::string& understood() const { return understood_; }

private:
    std::string understood_;
};

}  // namespace underbody::postproc
