#pragma once
struct orb_metadata;
#define ORB_ID(name) &__orb_##name
namespace uORB {
class Subscription {
public:
    explicit Subscription(const orb_metadata* meta);
    bool copy(void* to);
};
}  // namespace uORB
