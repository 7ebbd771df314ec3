#pragma once

namespace palpate::math {

/// What a team is asked to do: a reference to anything that is called as `work(member, size)` and
/// does not throw. It must outlive the run, so give run() a named function object.
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

/// Shares one piece of work among so many members. Results are the same from run to run as long as
/// they depend on `member` and `size` alone: which processor does a member's share does not matter.
class Team {
 public:
  virtual ~Team() = default;

  virtual int size() const noexcept = 0;

  /// Calls `task` once for every member, member 0 in the calling thread, and returns when all have
  /// finished; each sees what was written before. Shares may run one after the other in one
  /// thread, so they must not wait for one another. One thread at a time may call.
  virtual void run(TeamTask task) noexcept = 0;

  /// Says that work comes within some 100 microseconds, so that members are awake by then.
  virtual void call_up() noexcept {}
};

/// The calling thread alone.
class SoloTeam final : public Team {
 public:
  int size() const noexcept override { return 1; }
  void run(TeamTask task) noexcept override { task(0, 1); }
};

/// For all who are given no other; it has no state.
inline SoloTeam solo_team;

/// A member's part of `count` things in a row, begin to end - 1.
struct Share {
  Share(int count, int member, int size) noexcept
      : begin(static_cast<int>(static_cast<long>(count) * member / size)),
        end(static_cast<int>(static_cast<long>(count) * (member + 1) / size)) {}
  int size() const noexcept { return end - begin; }

  int begin, end;
};

}  // namespace palpate::math
