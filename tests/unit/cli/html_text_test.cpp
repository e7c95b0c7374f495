#include "cli/html_text.h"

#include <gtest/gtest.h>

namespace cs2mesh {
namespace {

TEST(HtmlText, NothingOfItIsMarkup) {
  EXPECT_EQ(escape_html("<b a=\"1\" b='2'>&amp;</b>"),
            "&lt;b a=&quot;1&quot; b=&#39;2&#39;&gt;&amp;amp;&lt;/b&gt;");
  EXPECT_EQ(escape_html("ein Bär"), "ein Bär");
  EXPECT_EQ(escape_html(std::string_view("a\0b\n", 4)), "a_b_");
}

TEST(HtmlText, Base64AsInItsStandard) {
  // RFC 4648, section 10.
  EXPECT_EQ(encode_base64(""), "");
  EXPECT_EQ(encode_base64("f"), "Zg==");
  EXPECT_EQ(encode_base64("fo"), "Zm8=");
  EXPECT_EQ(encode_base64("foo"), "Zm9v");
  EXPECT_EQ(encode_base64("foob"), "Zm9vYg==");
  EXPECT_EQ(encode_base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(encode_base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(encode_base64("\xff\xfe\xfd"), "//79");
  EXPECT_EQ(data_uri("image/png", "foo"), "data:image/png;base64,Zm9v");
}

}  // namespace
}  // namespace cs2mesh
