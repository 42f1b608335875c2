// An opened study: what it says and what its store holds. Immutable; a reload makes a new one.
#pragma once

#include <QMetaType>
#include <filesystem>
#include <memory>

#include "cases/study.h"

namespace underbody::studio {

struct Session {
    cases::Study study;
    cases::StudyResults results;
};

using SessionPointer = std::shared_ptr<const Session>;

/// Reads the study and what its store holds; computes nothing. Throws as cases::Study::open.
SessionPointer open_session(const std::filesystem::path& folder);

}  // namespace underbody::studio

Q_DECLARE_METATYPE(underbody::studio::SessionPointer)
