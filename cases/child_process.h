// A program that runs beside ours and ends with it.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace underbody::cases {

/// The file that `program` means on the PATH; nothing when there is none.
std::optional<std::filesystem::path> find_program(const std::string& program);

/// A child in a process group of its own, under a guard process of ours that leads the group. The whole group ends when
/// this object goes, and also when our process is killed without a chance to clean up: the guard sees that nobody holds
/// the other end of its pipe any more. What has put itself into another group or session is not reached.
class ChildProcess {
public:
    /// Starts `program` in a folder with its output and errors in `log`. `keep`: file descriptors that the guard and
    /// the child keep open (locks that last as long as anything of theirs runs); -1: none. Throws core::SystemError
    /// when it cannot be started.
    ChildProcess(const std::string& program, const std::vector<std::string>& arguments,
                 const std::filesystem::path& folder, const std::filesystem::path& log,
                 const std::vector<std::pair<std::string, std::string>>& environment = {},
                 std::array<int, 2> keep = {-1, -1});
    ~ChildProcess();
    ChildProcess(ChildProcess&& other) noexcept;
    ChildProcess& operator=(ChildProcess&&) = delete;
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;

    /// Its exit code (128 and the signal when it was killed) as soon as it has ended; nothing while it runs.
    std::optional<int> ended();
    /// Processor seconds of the group's processes and of those they have waited for, and whether one of them is
    /// stopped.
    struct Use {
        double processor_seconds = 0;
        bool stopped = false;
    };
    [[nodiscard]] Use use() const;
    /// Ends the group: politely, after two seconds by force.
    void stop();

private:
    int process_ = -1;  ///< the guard: leader of the group
    int pipe_ = -1;     ///< open as long as we live
    std::optional<int> code_;
};

}  // namespace underbody::cases
