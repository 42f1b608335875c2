#pragma once
#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
namespace rclcpp {
struct Duration {
    double seconds() const;
};
struct Time {
    Duration operator-(const Time& earlier) const;
};
struct TimerBase {
    using SharedPtr = std::shared_ptr<TimerBase>;
};
template <class Message>
struct Publisher {
    using SharedPtr = std::shared_ptr<Publisher>;
    void publish(const Message& message);
};
template <class Message>
struct Subscription {
    using SharedPtr = std::shared_ptr<Subscription>;
};
class Node {
public:
    explicit Node(const std::string& name);
    virtual ~Node();
    template <class Message>
    std::shared_ptr<Publisher<Message>> create_publisher(const std::string& topic, std::size_t depth);
    template <class Message>
    std::shared_ptr<Subscription<Message>> create_subscription(
        const std::string& topic, std::size_t depth, std::function<void(typename Message::SharedPtr)> callback);
    template <class Period>
    TimerBase::SharedPtr create_wall_timer(Period period, std::function<void()> callback);
    Time now() const;
};
void init(int argc, char** argv);
void spin(std::shared_ptr<Node> node);
bool shutdown();
}  // namespace rclcpp
