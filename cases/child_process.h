// A program that runs beside ours and ends with it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace underbody::cases {

/// The file that `program` means on the PATH; nothing when there is none.
std::optional<std::filesystem::path> find_program(const std::string& program);

/// A child in a process group of its own: the whole group ends with it, and when this object goes.
class ChildProcess {
public:
    /// Starts `program` in a folder with its output and errors in `log`. Throws core::SystemError when it cannot be started.
    ChildProcess(const std::string& program, const std::vector<std::string>& arguments, const std::filesystem::path& folder, const std::filesystem::path& log,
                 const std::vector<std::pair<std::string, std::string>>& environment = {});
    ~ChildProcess();
    ChildProcess(ChildProcess&& other) noexcept;
    ChildProcess& operator=(ChildProcess&&) = delete;
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;

    /// Its exit code (128 and the signal when it was killed) as soon as it has ended; nothing while it runs.
    std::optional<int> ended();
    /// Ends the group: politely, after two seconds by force.
    void stop();

private:
    int process_ = -1;
    std::optional<int> code_;
};

}  // namespace underbody::cases
