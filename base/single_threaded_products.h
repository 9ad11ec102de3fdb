// Eigen's own threads, switched off.
#pragma once

#include <Eigen/Core>

namespace bodyopt {

// While it lives, Eigen's products run on the thread that asks for them: their sums must not depend on how many threads
// there are, and work that runs in parallel as a whole is not helped by more of them.
class [[nodiscard]] SingleThreadedProducts {
 public:
  SingleThreadedProducts() : threads_(Eigen::nbThreads()) { Eigen::setNbThreads(1); }
  ~SingleThreadedProducts() { Eigen::setNbThreads(threads_); }
  SingleThreadedProducts(const SingleThreadedProducts&) = delete;
  SingleThreadedProducts& operator=(const SingleThreadedProducts&) = delete;

 private:
  int threads_;
};

}  // namespace bodyopt
