// Reading in a process of its own: what crashes, takes too much memory or is cancelled there.
#include <gmock/gmock.h>

#include <chrono>
#include <csignal>
#include <stdexcept>
#include <thread>

#include "core/error.h"
#include "core/file.h"
#include "postproc/importers/sandboxed_read.h"

namespace underbody::postproc {
namespace {

using testing::HasSubstr;

class Trial : public testing::Test {
protected:
    Trial() { core::write_file(path_, "some bytes"); }
    std::string refusal(const std::function<void()>& read) const {
        try {
            try_in_child(path_, read);
        } catch (const core::InputError& error) {
            return error.what();
        }
        return "";
    }
    core::TemporaryFolder folder_;
    std::filesystem::path path_ = folder_.path() / "file.cgns";
};

TEST_F(Trial, LetsPassWhatEndsWellOrRefusesInWords) {
    EXPECT_EQ(refusal([] {}), "");
    EXPECT_EQ(refusal([] { throw std::runtime_error("damaged"); }), "");  // the reading proper says so
}

TEST_F(Trial, RefusesWhatCrashesOrWantsTooMuch) {
    EXPECT_THAT(refusal([] { std::raise(SIGSEGV); }),
                testing::AllOf(HasSubstr("file.cgns"), HasSubstr("crashes on it")));
    EXPECT_THAT(refusal([] { throw std::bad_alloc(); }), HasSubstr("more memory than the file can justify"));
}

TEST_F(Trial, EndsAtOnceWhenCancelled) {
    using Clock = std::chrono::steady_clock;
    core::Progress progress;
    Clock::time_point asked;
    std::thread user([&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        asked = Clock::now();
        progress.cancel();
    });
    EXPECT_THROW(try_in_child(
                     path_, [] { std::this_thread::sleep_for(std::chrono::seconds(30)); }, progress),
                 core::Cancelled);
    user.join();
    EXPECT_LT(Clock::now() - asked, std::chrono::seconds(20));  // a tenth and what a busy machine takes, not the 30 s
}

}  // namespace
}  // namespace underbody::postproc
