// What is open: a study with what its store holds, and files from outside it. Immutable; a reload makes a new one.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "cases/found_force.h"
#include "cases/study.h"
#include "core/error.h"
#include "geometry/body/body_shape.h"

namespace underbody::studio {

/// What was found of the tables of a session: to know it models are read and their tables fitted, and it is asked for
/// whenever the tree or an export is shown. Another session begins without, a copy too.
class KnownForces {
public:
    struct Known {
        std::string stamp;  ///< of the models' files as they were read
        std::optional<cases::FoundForce> found;
        std::string digest;  ///< table_digest()
    };
    KnownForces() = default;
    KnownForces(const KnownForces&) {}
    KnownForces& operator=(const KnownForces&) = delete;
    [[nodiscard]] std::optional<Known> of(const std::string& table, const std::string& stamp) const;
    void keep(const std::string& table, const Known& known) const;

private:
    mutable std::mutex mutex_;  // jobs ask too
    mutable std::map<std::string, Known> known_;
};

struct Session {
    std::filesystem::path folder;  ///< of the study, absolute; empty: none is open
    cases::Study study;
    cases::StudyResults results;
    /// By name: the [[body]]s of the study, and shapes from outside by the name of their file.
    std::map<std::string, geometry::BodyShape> shapes;
    std::map<std::string, std::filesystem::path> shape_files;
    core::Problems problems;                  ///< shapes that cannot be read
    std::set<std::string> accepted;           ///< measurements whose found model stands in `study`
    std::shared_ptr<const Session> declared;  ///< without them; nullptr: this one
    KnownForces known_forces;
};

using SessionPointer = std::shared_ptr<const Session>;

/// The same with the found models of these measurements in the place of their declared ones. Throws as
/// cases::with_accepted.
SessionPointer with_models(const SessionPointer& session, const std::set<std::string>& accepted);

/// Reads the study and what its store holds; computes nothing. Throws as cases::Study::open. A shape that cannot be
/// read is a problem of the session. An empty `folder`: no study, only the shapes of `files`.
SessionPointer open_session(const std::filesystem::path& folder, const std::vector<std::string>& files = {});

/// The same study and results with the shapes of other outside files.
SessionPointer with_files(const Session& session, const std::vector<std::string>& files);

/// The views of cases that the store has pictures of: "pressure-underbody", ...
std::vector<std::string> case_views(const Session& session);
/// The key of such a picture of a case among the results, of the first [[picture]] that has one; empty: there is none.
std::string case_picture(const Session& session, const std::string& view, const std::string& name);

}  // namespace underbody::studio
