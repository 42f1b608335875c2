// The only way from one state to another: a verb with its words. The line of an action is what the log keeps and
// `underbody-studio --replay` takes.
#pragma once

#include <string>
#include <vector>

#include "studio/desktop/state/state.h"
#include "studio/desktop/state/words.h"

namespace underbody::studio {

struct ActionKind {
    std::string verb;
    std::string arguments;  ///< for people: "PARAMETER=VALUE ..."
    std::string meaning;
    std::string example;  ///< a whole line
    bool view = false;    ///< changes what is seen only: successive ones are one step of the history
    State (*apply)(State state, const Words& arguments, const Session& session);
    bool glance = false;  ///< a look at something else, which never drops what can be redone
};
const std::vector<ActionKind>& action_kinds();

/// Throws core::UsageError for an unknown verb, with the nearest one.
const ActionKind& kind_of(const Words& words);

/// The state after an action. Throws core::Error: unknown verbs, names and keys with the nearest, values that do not
/// parse or cannot be (a shape that cannot be made: the sentence of geometry::check).
State applied(const State& state, const Words& words, const Session& session);

/// As `turn` takes it.
std::string text_of(const ViewPose& pose);

/// "Set protrusion.height to 2 mm": for the history.
std::string name_of(const Words& words);

/// Actions with the same key within one gesture (a drag), and view actions of the same kind one after the other, are
/// one step.
std::string merge_key(const Words& words);

/// `underbody body FILE --set ...` of a shape as it is in the state.
Words shape_command(const State& state, const Session& session, const std::string& name);

/// The command line that does the same outside the window, of the state after the action; empty for what changes the
/// view only.
std::string command_of(const State& after, const Words& words, const Session& session);

}  // namespace underbody::studio
