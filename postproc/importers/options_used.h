// Which of the reader's options a file had a use for.
#pragma once

#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "postproc/field/field.h"

namespace underbody::postproc {

/// The variables whose units were looked up; several threads may do so.
class AskedUnits {
public:
    void add(const std::string& variable) {
        const std::lock_guard lock(mutex_);
        names_.insert(variable);
    }
    [[nodiscard]] std::vector<std::string> names() const {
        const std::lock_guard lock(mutex_);
        return {names_.begin(), names_.end()};
    }

private:
    mutable std::mutex mutex_;
    std::set<std::string> names_;
};

/// Before reading: throws core::InputError for a time or a companion where files of this format have none, and for a
/// length unit that is none of lengths.
void refuse_useless_options(const std::string& format, const ReadOptions& options, const core::Place& place);

/// After reading: throws core::InputError for a unit stated for a variable that nothing was found like; a unit of
/// length that the file contradicts becomes a warning of the field.
void check_options_used(Field& field, const ReadOptions& options, const core::Place& place);

}  // namespace underbody::postproc
