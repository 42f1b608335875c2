// Every step with the state before and after it: undo and redo by name, as far as one likes.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "studio/desktop/state/actions.h"

namespace underbody::studio {

class History {
public:
    struct Step {
        std::string name;     ///< for people
        std::string line;     ///< of the last action in it
        std::string command;  ///< the command line that does the same; may be empty
        std::string merge_key;
        std::string gesture;
        StatePointer before, after;
        bool view = false;
    };

    explicit History(State start = {});

    [[nodiscard]] const StatePointer& state() const { return state_; }
    [[nodiscard]] const std::vector<Step>& steps() const { return steps_; }
    /// How many of the steps are done (the others can be redone).
    [[nodiscard]] std::size_t position() const { return position_; }

    /// Carries an action out. False when it changed nothing (no step then). What was undone is dropped, but a change
    /// not by a look at something else, which is no step then. Actions of one `gesture` (a drag; not empty) with the
    /// same merge key are one step. Throws as `applied`; the state stays.
    bool act(const Words& words, const Session& session, const std::string& gesture = {});
    /// The line of a gesture is logged when it ends.
    void end_gesture();
    /// False when there is nothing to undo or redo.
    bool undo();
    bool redo();
    /// Undoes or redoes until `position` steps are done.
    void go_to(std::size_t position);

    /// Gets every line for the log: actions, "undo", "redo".
    std::function<void(const std::string& line)> on_line;

private:
    void log(const std::string& line);
    /// Looks about while there is something to redo: no step.
    void look(StatePointer next, const std::string& line, const std::string& gesture);
    StatePointer state_;
    std::vector<Step> steps_;
    std::size_t position_ = 0;
    std::string held_line_;  ///< of a gesture that goes on
    std::string looking_;    ///< that gesture, where it looks about
};

}  // namespace underbody::studio
