#include "studio/desktop/state/session.h"

#include <algorithm>

#include "cases/accept.h"

namespace underbody::studio {

namespace fs = std::filesystem;

namespace {

void add_shape(Session& session, const std::string& name, const fs::path& file) {
    try {
        session.shapes[name] = geometry::read_shape(file);
        session.shape_files[name] = file;
    } catch (const core::Error& error) {
        session.problems.push_back({core::Problem::Severity::error,
                                    error.message() + (error.hint().empty() ? "" : "; " + error.hint()),
                                    error.place()});
    }
}

/// Outside files are kept as "KIND:PATH".
void add_files(Session& session, const std::vector<std::string>& files) {
    for (const auto& file : files) {
        if (file.starts_with("shape:")) {
            const fs::path path = file.substr(6);
            add_shape(session, path.stem().string(), path);
        }
    }
}

void add_bodies(Session& session) {
    for (const auto& body : session.study.bodies) {
        add_shape(session, body.name, body.shape);
    }
}

}  // namespace

std::optional<KnownForces::Known> KnownForces::of(const std::string& table, const std::string& stamp) const {
    const std::lock_guard lock(mutex_);
    const auto at = known_.find(table);
    return at == known_.end() || at->second.stamp != stamp ? std::nullopt : std::optional(at->second);
}

void KnownForces::keep(const std::string& table, const Known& known) const {
    const std::lock_guard lock(mutex_);
    known_[table] = known;
}

SessionPointer open_session(const fs::path& folder, const std::vector<std::string>& files) {
    auto session = std::make_shared<Session>();
    if (!folder.empty()) {
        session->study = cases::Study::open(folder);
        session->folder = (fs::absolute(session->study.folder()) / "x").lexically_normal().parent_path();
        session->results = cases::stored_results(session->study, {});
    }
    add_bodies(*session);
    add_files(*session, files);
    return session;
}

SessionPointer with_models(const SessionPointer& session, const std::set<std::string>& accepted) {
    if (session->accepted == accepted) {
        return session;
    }
    const SessionPointer declared = session->declared ? session->declared : session;
    if (accepted.empty()) {
        return declared;
    }
    auto newer = std::make_shared<Session>(*declared);
    for (const auto& name : accepted) {
        newer->study = cases::with_accepted(newer->study, newer->results, name);
    }
    newer->accepted = accepted;
    newer->declared = declared;
    return newer;
}

SessionPointer with_files(const Session& session, const std::vector<std::string>& files) {
    auto newer = std::make_shared<Session>(session);
    newer->shapes.clear();
    newer->shape_files.clear();
    newer->problems.clear();
    add_bodies(*newer);
    add_files(*newer, files);
    return newer;
}

std::vector<std::string> case_views(const Session& session) {
    std::vector<std::string> found;
    for (const auto& spec : session.study.pictures) {
        for (const auto& [key, png] : session.results.pictures) {
            const std::string view = key.substr(key.rfind('/') + 1);
            if (key.starts_with("picture/" + spec.name + "/") &&
                std::find(found.begin(), found.end(), view) == found.end()) {
                found.push_back(view);
            }
        }
    }
    return found;
}

std::string case_picture(const Session& session, const std::string& view, const std::string& name) {
    for (const auto& spec : session.study.pictures) {
        const std::string key = "picture/" + spec.name + "/" + name + "/" + view;
        if (session.results.picture(key) != nullptr) {
            return key;
        }
    }
    return {};
}

}  // namespace underbody::studio
