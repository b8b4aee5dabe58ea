// The main function of all test programs. Where CTest runs a whole suite as one test, it learns no more than
// the exit code.

#include <gtest/gtest.h>

int main(int argc, char** argv) {
  constexpr int kSkipped = 77;
  testing::InitGoogleTest(&argc, argv);
  const int result = RUN_ALL_TESTS();
  return result == 0 && testing::UnitTest::GetInstance()->skipped_test_count() > 0 ? kSkipped : result;
}
