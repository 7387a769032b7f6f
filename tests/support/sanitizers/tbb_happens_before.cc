// Tells ThreadSanitizer how TBB orders threads.
//
// Debian's libtbb is not instrumented, so the sanitizer sees none of the scheduler's hand-overs: it
// calls every task a race with whoever spawned it. Suppressing all frames below libtbb would hide
// the true races too, since every task has such frames. So the scheduler's entry points, which
// TBB's headers call, are taken over here: they state the order (spawn before execute, execute
// before the end of the wait) and pass on to the library. Task memory comes from malloc, whose
// reuse the sanitizer understands, in place of TBB's pools.

#include <dlfcn.h>
#include <sanitizer/tsan_interface.h>
#include <tbb/task_group.h>

#include <cstdlib>
#include <new>

namespace tbb::detail::r1 {
namespace {

/// Executes a task after acquiring what its spawner had done.
class OrderedTask final : public d1::task {
 public:
  explicit OrderedTask(d1::task& inner) : inner_(&inner) { __tsan_release(this); }

  d1::task* execute(d1::execution_data& data) override { return take()->execute(data); }
  d1::task* cancel(d1::execution_data& data) override { return take()->cancel(data); }

 private:
  d1::task* take() {
    __tsan_acquire(this);
    d1::task* inner = inner_;
    delete this;
    return inner;
  }

  d1::task* inner_;
};

/// The function of this (mangled) name in libtbb.
template <typename Function>
Function* in_libtbb(const char* name) {
  void* found = dlsym(RTLD_NEXT, name);
  if (found == nullptr) std::abort();  // another TBB: the sanitizer run would mean nothing
  return reinterpret_cast<Function*>(found);
}

/// Tasks end by lowering the count behind the first word of the context: an atomic of the header.
void acquire_end_of(d1::wait_context& context) {
  __tsan_acquire(reinterpret_cast<char*>(&context) + sizeof(std::uint64_t));
}

void* allocate_task(d1::small_object_pool*& pool, std::size_t bytes) {
  static char no_pool;  // only handed back to deallocate
  pool = reinterpret_cast<d1::small_object_pool*>(&no_pool);
  void* memory = std::malloc(bytes);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

void spawn(d1::task& task, d1::task_group_context& context) {
  static const auto next = in_libtbb<void(d1::task&, d1::task_group_context&)>(
      "_ZN3tbb6detail2r15spawnERNS0_2d14taskERNS2_18task_group_contextE");
  next(*new OrderedTask(task), context);
}

void spawn(d1::task& task, d1::task_group_context& context, d1::slot_id slot) {
  static const auto next = in_libtbb<void(d1::task&, d1::task_group_context&, d1::slot_id)>(
      "_ZN3tbb6detail2r15spawnERNS0_2d14taskERNS2_18task_group_contextEt");
  next(*new OrderedTask(task), context, slot);
}

void execute_and_wait(d1::task& task, d1::task_group_context& task_context, d1::wait_context& wait,
                      d1::task_group_context& wait_context) {
  static const auto next = in_libtbb<void(d1::task&, d1::task_group_context&, d1::wait_context&,
                                          d1::task_group_context&)>(
      "_ZN3tbb6detail2r116execute_and_waitERNS0_2d14taskERNS2_18task_group_contextE"
      "RNS2_12wait_contextES6_");
  next(task, task_context, wait, wait_context);
  acquire_end_of(wait);
}

void wait(d1::wait_context& wait_context, d1::task_group_context& context) {
  static const auto next = in_libtbb<void(d1::wait_context&, d1::task_group_context&)>(
      "_ZN3tbb6detail2r14waitERNS0_2d112wait_contextERNS2_18task_group_contextE");
  next(wait_context, context);
  acquire_end_of(wait_context);
}

void* allocate(d1::small_object_pool*& pool, std::size_t bytes, const d1::execution_data&) {
  return allocate_task(pool, bytes);
}
void* allocate(d1::small_object_pool*& pool, std::size_t bytes) {
  return allocate_task(pool, bytes);
}
void deallocate(d1::small_object_pool&, void* memory, std::size_t, const d1::execution_data&) {
  std::free(memory);
}
void deallocate(d1::small_object_pool&, void* memory, std::size_t) { std::free(memory); }

}  // namespace tbb::detail::r1
