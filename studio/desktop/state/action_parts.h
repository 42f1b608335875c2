// Words of actions read into values, and the actions that stand in files of their own.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "studio/desktop/state/actions.h"

namespace underbody::studio::action {

/// Throws core::UsageError unless there are so many words; `form` says how it is written.
void need(const Words& arguments, std::size_t least, std::size_t most, const char* form);
/// "KEY=VALUE" in two; the value may hold '='. Throws core::UsageError.
std::pair<std::string, std::string> assignment(const std::string& word);
[[noreturn]] void unknown_key(const std::string& key, const std::vector<std::string>& known);
/// "on" or "off". Throws core::UsageError.
bool yes_or_no(const std::string& text);
/// Empty: none. Throws core::UsageError.
std::optional<double> number_or_none(const std::string& text, const char* unit);
/// The value. Throws core::UsageError beyond the limits.
double within(double value, double lower, double upper, const std::string& what);
/// "LOW:HIGH". Throws core::UsageError.
std::array<double, 2> range_of(const std::string& text, const char* unit);
/// The shape that Design shows. Throws core::UsageError when there is none.
std::string need_shape(const State& state, const Session& session);

/// "X,Y,Z/X,Y,Z/X,Y,Z/HEIGHT" as ViewPose; empty: none. Throws core::Error: no such, or nothing could be seen from it.
std::optional<ViewPose> pose_from(const std::string& text);

State turn(State state, const Words& words, const Session& session);
State outline(State state, const Words& words, const Session& session);
State look_at_fields(State state, const Words& words, const Session& session);
State read_as(State state, const Words& words, const Session& session);
State measure(State state, const Words& words, const Session& session);
State look_at_table(State state, const Words& words, const Session& session);
State look_at_region(State state, const Words& words, const Session& session);
State explore_axes(State state, const Words& words, const Session& session);
State order(State state, const Words& words, const Session& session);
State brush(State state, const Words& words, const Session& session);
State vary(State state, const Words& words, const Session& session);
State rows(State state, const Words& words, const Session& session);
State show(State state, const Words& words, const Session& session);
State choose_cells(State state, const Words& words, const Session& session);

}  // namespace underbody::studio::action
