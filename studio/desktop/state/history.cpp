#include "studio/desktop/state/history.h"

#include <algorithm>

namespace underbody::studio {

History::History(State start) : state_(std::make_shared<const State>(std::move(start))) {}

void History::log(const std::string& line) {
    if (on_line) {
        on_line(line);
    }
}

void History::end_gesture() {
    if (!held_line_.empty()) {
        const std::string line = held_line_;
        held_line_.clear();
        log(line);
    }
    looking_.clear();
    if (position_ > 0) {
        steps_[position_ - 1].gesture.clear();
    }
}

bool History::act(const Words& words, const Session& session, const std::string& gesture) {
    State next = applied(*state_, words, session);
    if (next == *state_) {
        return false;
    }
    const std::string key = merge_key(words);
    const bool view = kind_of(words).view;
    const auto undone = steps_.begin() + static_cast<std::ptrdiff_t>(position_);
    if (kind_of(words).glance && !std::all_of(undone, steps_.end(), [](const Step& step) { return step.view; })) {
        look(std::make_shared<const State>(std::move(next)), line_of(words), gesture);
        return true;
    }
    const bool at_end = position_ == steps_.size() && position_ > 0;
    Step* last = at_end ? &steps_.back() : nullptr;
    const bool same_gesture = last != nullptr && !gesture.empty() && last->gesture == gesture && last->merge_key == key;
    const bool same_view = last != nullptr && view && last->view && last->merge_key == key;
    if (!same_gesture) {
        end_gesture();
    }
    if (same_gesture && next == *last->before) {  // dragged back to where it began
        state_ = last->before;
        held_line_.clear();
        steps_.pop_back();
        --position_;
        return true;
    }
    const auto after = std::make_shared<const State>(std::move(next));
    if (!same_gesture && !same_view) {
        steps_.resize(position_);
        steps_.push_back({{}, {}, {}, key, gesture, state_, {}, view});
        ++position_;
    }
    Step& step = steps_.back();
    step.name = name_of(words);
    step.line = line_of(words);
    step.command = command_of(*after, words, session);
    step.after = after;
    step.gesture = gesture;
    state_ = after;
    if (gesture.empty()) {
        log(step.line);
    } else {
        held_line_ = step.line;
    }
    return true;
}

void History::look(StatePointer next, const std::string& line, const std::string& gesture) {
    if (gesture.empty() || gesture != looking_) {
        end_gesture();
    }
    looking_ = gesture;
    state_ = std::move(next);
    if (gesture.empty()) {
        log(line);
    } else {
        held_line_ = line;
    }
}

bool History::undo() {
    end_gesture();
    if (position_ == 0) {
        return false;
    }
    state_ = steps_[--position_].before;
    log("undo");
    return true;
}

bool History::redo() {
    end_gesture();
    if (position_ == steps_.size()) {
        return false;
    }
    state_ = steps_[position_++].after;
    log("redo");
    return true;
}

void History::go_to(std::size_t position) {
    while (position_ > position && undo()) {
    }
    while (position_ < position && redo()) {
    }
}

}  // namespace underbody::studio
