// Empty: taxelsim_test_headers needs a source.
