#pragma once

namespace palpate::math {

/// Task of a team: a reference to an object callable as `work(member, size)` that does not throw.
/// The object must outlive the run, so pass a named function object to run().
class TeamTask {
 public:
  template <class Work>
  TeamTask(const Work& work) noexcept
      : work_(&work), call_([](const void* it, int member, int size) noexcept {
          (*static_cast<const Work*>(it))(member, size);
        }) {}
  TeamTask() noexcept = default;

  void operator()(int member, int size) const noexcept { call_(work_, member, size); }

 private:
  const void* work_ = nullptr;
  void (*call_)(const void*, int, int) noexcept = nullptr;
};

/// Divides work among a fixed number of members. Results are reproducible if they depend on
/// `member` and `size` only, whichever processor runs a member's share.
class Team {
 public:
  virtual ~Team() = default;

  virtual int size() const noexcept = 0;

  /// Calls `task` once per member, member 0 in the calling thread, and returns when all have
  /// finished; writes before the call are visible to all members. Shares may run sequentially in
  /// one thread and must not wait for one another. Not thread-safe.
  virtual void run(TeamTask task) noexcept = 0;

  /// Announces work within about 100 microseconds, so that members can wake up.
  virtual void call_up() noexcept {}
};

/// Team of the calling thread only.
class SoloTeam final : public Team {
 public:
  int size() const noexcept override { return 1; }
  void run(TeamTask task) noexcept override { task(0, 1); }
};

/// Default team; stateless.
inline SoloTeam solo_team;

/// Part of `count` consecutive items assigned to a member, begin to end - 1.
struct Share {
  Share(int count, int member, int size) noexcept
      : begin(static_cast<int>(static_cast<long>(count) * member / size)),
        end(static_cast<int>(static_cast<long>(count) * (member + 1) / size)) {}
  int size() const noexcept { return end - begin; }

  int begin, end;
};

}  // namespace palpate::math
